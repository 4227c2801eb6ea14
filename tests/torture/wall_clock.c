// A wall clock that can be set: loaded before all other libraries (LD_PRELOAD), it shifts what a
// process reads from it. Who waits until a time of day waits no longer than before.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <time.h>

static long shift;

void shift_wall_clock(long seconds) { shift += seconds; }

int clock_gettime(clockid_t clock, struct timespec *now) {
  static int (*real)(clockid_t, struct timespec *);
  if (!real) real = dlsym(RTLD_NEXT, "clock_gettime");
  int result = real(clock, now);
  if (clock == CLOCK_REALTIME) now->tv_sec += shift;
  return result;
}

int pthread_cond_clockwait(pthread_cond_t *condition, pthread_mutex_t *mutex, clockid_t clock,
                           const struct timespec *until) {
  static int (*real)(pthread_cond_t *, pthread_mutex_t *, clockid_t, const struct timespec *);
  if (!real) real = dlsym(RTLD_NEXT, "pthread_cond_clockwait");
  struct timespec shifted = *until;
  if (clock == CLOCK_REALTIME) shifted.tv_sec -= shift;
  return real(condition, mutex, clock, &shifted);
}

int pthread_cond_timedwait(pthread_cond_t *condition, pthread_mutex_t *mutex,
                           const struct timespec *until) {
  // The first version of the name is for programs of 2002.
  static int (*real)(pthread_cond_t *, pthread_mutex_t *, const struct timespec *);
  if (!real) real = dlvsym(RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2");
  struct timespec shifted = *until;
  // Which clock it is does not say; one that counts from the start of the machine is far smaller.
  if (shifted.tv_sec > 1000000000) shifted.tv_sec -= shift;
  return real(condition, mutex, &shifted);
}
