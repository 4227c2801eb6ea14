"""The process that launches: it starts programs, watches them, and ends them all.

Everything is visited before anything is started, also what timers and events will lead to, so
that a file with a fault starts nothing. Each program has a process group of its own: Ctrl-C
reaches this process only, which interrupts the others, once, and whatever they have started.
"""

from __future__ import annotations

import asyncio
import contextlib
import ctypes
import functools
import os
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from labkit.errors import LabError
from labkit.launching import events
from labkit.launching.event_handlers import BaseEventHandler, entities_in
from labkit.launching.execute import Start, Written
from labkit.launching.launch_files import load
from labkit.launching.lifecycle_nodes import ChangeState
from labkit.launching.managed_nodes import ManagedNodes
from labkit.launching.model import Action, Context, Timer, raised

__all__ = ['Service']

PR_SET_PDEATHSIG = 1
_libc = ctypes.CDLL(None)
# What the modes of output show; all of it is in the log file.
_SHOWN = {'log': {2}, 'own_log': set[int](), 'screen': {1, 2}, 'both': {1, 2}, 'full': {1, 2}}
_ENDING = (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


class _Program:
    """A program that is running, or about to be started again."""

    def __init__(self, start: Start) -> None:
        self.start = start
        self.left = start.retries
        self.popen: subprocess.Popen[bytes] | None = None
        self.words: list[str] = []
        self.about: dict[str, Any] = {}  # what events tell of it
        self.rest = {1: b'', 2: b''}
        self.timers: list[asyncio.TimerHandle] = []
        self.ending = False

    @property
    def pid(self) -> int:
        """Its process id, which is that of its group too."""
        assert self.popen is not None
        return self.popen.pid

    def send(self, number: int) -> None:
        """Send a signal to it, and to what it has started."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, number)


class Service:
    """Visits a description, and runs what it asks for until all of it has ended.

    Args:
        actions: What to visit.
        interactive: Whether a person sits before it, whose Ctrl-C needs no words.
        debug: Whether to tell more.
        argv: Arguments of the command line, for those in a launch file who ask.
        tell: Is told what happens, for a program that watches.
    """

    def __init__(
        self,
        actions: Sequence[Action],
        *,
        interactive: bool = False,
        debug: bool = False,
        argv: Sequence[str] = (),
        tell: Callable[[dict[str, Any]], None] | None = None,
    ) -> None:
        self._actions = actions
        self._interactive, self._debug = interactive, debug
        self._tell = tell or (lambda event: None)
        self._quiet = tell is not None
        self._context = Context(
            argv=list(argv), noninteractive=not interactive, say=self._say, load=load
        )
        self._programs: list[_Program] = []
        self._timers: dict[asyncio.TimerHandle, Timer] = {}
        self._asked_to_end = self._shutting_down = self._interrupted = False
        self._code = 0
        self._ended_by: int | None = None
        self._log: Any = None

    def run(self) -> int:
        """Run it, and return the exit code: 1 if something went wrong in the launch itself.

        A signal that ends it, but Ctrl-C, ends the process too, when all programs have ended.

        Raises:
            LabError: Something is wrong in the files. Nothing was started.
        """
        self._loop = loop = asyncio.new_event_loop()
        self._done = loop.create_future()
        with contextlib.ExitStack() as stack:
            stack.callback(loop.close)
            self._folder = stack.enter_context(tempfile.TemporaryDirectory(prefix='launch_'))
            self._open_log(stack)
            self._context.visit(self._actions)
            self._context.push_environment()
            self._rehearse()
            self._context.pop_environment()
            loop.set_exception_handler(self._on_error)
            loop.add_signal_handler(signal.SIGCHLD, self._reap)
            for number in (signal.SIGINT, *_ENDING):
                stack.callback(signal.signal, number, signal.signal(number, self._on_signal))
            self._managed = ManagedNodes(loop, self._say, self._on_transition, self._runs)
            stack.callback(self._managed.close)
            stack.callback(self._kill_all)
            loop.call_soon(self._begin)
            loop.run_until_complete(self._done)
        if self._ended_by is not None:  # as if nobody had handled it
            signal.signal(self._ended_by, signal.SIG_DFL)
            os.kill(os.getpid(), self._ended_by)
        return self._code

    def _on_error(self, _: Any, context: dict[str, Any]) -> None:
        """End with an error of the launch's own."""
        if not self._done.done():
            self._done.set_exception(context.get('exception') or LabError(context['message']))

    def _rehearse(self) -> None:
        """Visit what timers and events will lead to, without doing it.

        Raises:
            LabError: Something is wrong in it.
        """
        trial = self._context.rehearsal()
        trial.timers = list(self._context.timers)
        trial.handlers = list(self._context.handlers)
        done: list[Any] = []
        while True:
            known: list[Any] = [*trial.timers, *trial.handlers]
            waiting = [one for one in known if one not in done]
            if not waiting:
                return
            for one in waiting:
                done.append(one)
                held = self._context.launch_configurations
                trial.files = list(one.files)
                trial.launch_configurations = dict(getattr(one, 'configurations', held))
                trial.visit(one.actions)

    def _begin(self) -> None:
        self._settle()
        self._tell({'ready': True})
        self._end_if_idle()

    def _settle(self) -> None:
        """Do what the context was asked for: start programs and timers, let events happen."""
        context = self._context
        while context.starts or context.timers or context.events:
            for action in context.managed:  # before its program starts
                self._managed.watch(action)
            context.managed.clear()
            starts, context.starts = context.starts, []
            timers, context.timers = context.timers, []
            happened, context.events = context.events, []
            for start in starts:
                if not (self._shutting_down or self._asked_to_end):
                    program = _Program(start)
                    self._programs.append(program)
                    self._start(program)
            for timer in timers:
                if not (self._shutting_down and timer.cancel_on_shutdown):
                    self._begin_timer(timer)
            for event in happened:
                self._emit(event)

    def _begin_timer(self, timer: Timer) -> None:
        def fire() -> None:
            del self._timers[handle]
            self._context.push_configurations()
            self._context.launch_configurations = dict(timer.configurations)
            self._visit(lambda: timer.actions, events.TimerEvent(timer), timer.files)
            self._context.pop_configurations()
            self._settle()
            self._tell_timers()
            self._end_if_idle()

        handle = self._loop.call_later(timer.seconds, fire)
        self._timers[handle] = timer
        self._tell_timers()

    def _tell_timers(self) -> None:
        self._tell({'timers': [timer.seconds for timer in self._timers.values()]})

    def _visit(self, actions: Callable[[], Any], event: Any, files: Sequence[str]) -> None:
        """Visit actions while the launch runs; a fault in them ends it."""
        context = self._context
        context.extend_locals({'event': event})
        context.files = list(files)
        try:
            context.visit(entities_in(actions()))
        except Exception as error:  # a function of a launch file may raise anything
            why = error if isinstance(error, LabError) else raised(error)
            self._fail(f'Caught exception in launch: {why}')
        finally:
            context.clear_locals()
            context.files = []

    def _fail(self, why: str) -> None:
        self._code = 1
        self._say('ERROR', 'launch', why)
        self._context.events.append(events.Shutdown(why))

    def _emit(self, event: events.Event) -> None:
        if isinstance(event, events.Shutdown):
            if self._shutting_down:
                return
            self._shutting_down = self._context.is_shutdown = True
        if self._debug:
            self._say('DEBUG', 'launch', f'processing event: {type(event).__name__}')
        for handler in list(self._context.handlers):
            handle = functools.partial(_handled, handler, event, self._context)
            self._visit(handle, event, handler.files)
        if isinstance(event, events.Shutdown):
            self._shut_down(due_to_sigint=event.due_to_sigint)
        elif isinstance(event, events.ProcessTargetedEvent):
            self._ask(event)
        elif isinstance(event, ChangeState):
            self._managed.change(event)

    def _on_transition(self, event: events.Event) -> None:
        self._emit(event)
        self._settle()
        self._end_if_idle()

    def _runs(self, action: Action) -> bool:
        """Return whether the program of an action runs, or is about to."""
        return any(program.start.action is action for program in self._programs)

    def _ask(self, event: events.ProcessTargetedEvent) -> None:
        """Send a signal to the programs that an event is about."""
        for program in list(self._programs):
            if program.popen is None or not event.process_matcher(program.start.action):
                continue
            if isinstance(event, events.SignalProcess):
                self._signal(program, signal.Signals[event.signal_name], said=True)
            elif isinstance(event, events.ShutdownProcess):
                self._end(program, said=True)

    def _start(self, program: _Program) -> None:
        start = program.start
        program.words = [self._word(word) for word in start.command]
        try:
            program.popen = popen = subprocess.Popen(
                ' '.join(program.words) if start.shell else program.words,
                shell=start.shell,
                cwd=start.cwd,
                # What a program in Python prints is not to wait for more.
                env={'PYTHONUNBUFFERED': '1', **start.environment},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                preexec_fn=_on_its_own,
            )
        except OSError as error:
            self._programs.remove(program)
            self._say('ERROR', start.name, f'can not be started: {error.strerror}')
            self._over(start.action)
            return
        self._say('INFO', start.name, f'process started with pid [{popen.pid}]')
        if self._debug or start.log_command:
            self._say('INFO', start.name, f"process details: cmd='{' '.join(program.words)}'")
        for fd, stream in ((1, popen.stdout), (2, popen.stderr)):
            assert stream is not None
            os.set_blocking(stream.fileno(), False)
            self._loop.add_reader(stream.fileno(), self._read, program, fd, stream.fileno())
        self._tell({'started': start.name, 'pid': popen.pid, 'node': start.is_node})
        details = {'cmd': program.words, 'cwd': start.cwd, 'env': start.environment}
        program.about = {'process_name': start.name, 'pid': popen.pid, **details}
        start.action.process_details = {'name': start.name, 'pid': popen.pid, **details}
        self._emit(events.ProcessStarted(start.action, **program.about))

    def _word(self, word: str | Written) -> str:
        if isinstance(word, str):
            return word
        handle, path = tempfile.mkstemp(prefix='launch_params_', dir=self._folder)
        with open(handle, 'w', encoding='utf-8') as file:
            file.write(word.text)
        return path

    def _read(self, program: _Program, fd: int, number: int) -> bool:
        """Show what a program has written; return whether more may follow."""
        try:
            data = os.read(number, 65536)
        except BlockingIOError:
            return False
        if not data:
            self._loop.remove_reader(number)
        *lines, program.rest[fd] = (program.rest[fd] + data).split(b'\n')
        for line in lines:
            self._show(program, fd, line)
        if data:
            kind = events.ProcessStdout if fd == 1 else events.ProcessStderr
            self._emit(kind(program.start.action, **program.about, text=data))
        return bool(data)

    def _show(self, program: _Program, fd: int, line: bytes) -> None:
        text = f'[{program.start.name}] {line.decode(errors="replace").rstrip()}'
        self._write(text, shown=fd in _SHOWN[program.start.output])

    def _reap(self) -> None:
        for program in list(self._programs):
            if program.popen is not None and program.popen.poll() is not None:
                self._ended(program, program.popen)
        self._settle()
        self._end_if_idle()

    def _ended(self, program: _Program, popen: subprocess.Popen[bytes]) -> None:
        start, code = program.start, popen.returncode
        self._programs.remove(program)
        program.send(signal.SIGKILL)  # what it has left behind
        for fd, stream in ((1, popen.stdout), (2, popen.stderr)):
            assert stream is not None
            while self._read(program, fd, stream.fileno()):
                pass
            self._loop.remove_reader(stream.fileno())
            stream.close()
            if program.rest[fd]:
                self._show(program, fd, program.rest[fd])
            program.rest[fd] = b''
        for timer in program.timers:
            timer.cancel()
        program.popen = None
        if code == 0:
            self._say('INFO', start.name, f'process has finished cleanly [pid {popen.pid}]')
        else:
            what = f"pid {popen.pid}, exit code {code}, cmd '{' '.join(program.words)}'"
            self._say('ERROR', start.name, f'process has died [{what}].')
        again = bool(start.respawn and program.left and not program.ending)
        again = again and not self._shutting_down
        told = {'ended': start.name, 'exit_code': code, 'again': again, 'left': program.left}
        told['delay'] = start.respawn_delay
        self._tell({**told, 'shutting_down': self._shutting_down})
        self._emit(events.ProcessExited(start.action, **program.about, returncode=code))
        self._settle()
        if again and not self._shutting_down:
            program.left -= 1
            self._programs.append(program)
            program.timers = [self._loop.call_later(start.respawn_delay, self._again, program)]
            return
        self._over(start.action)

    def _over(self, action: Action) -> None:
        """Note that nothing more comes of an action that starts a program."""
        self._managed.abandon('' if self._shutting_down else 'the end of its program', action)
        self._emit(events.ExecutionComplete(action))

    def _again(self, program: _Program) -> None:
        self._start(program)
        self._settle()
        self._end_if_idle()

    def _on_signal(self, number: int, _: Any) -> None:
        # Not by the loop alone: it may be about to start a thousand programs.
        self._asked_to_end = True
        if number == signal.SIGINT:
            self._loop.call_soon_threadsafe(self._on_sigint)
        else:
            self._loop.call_soon_threadsafe(self._on_sigterm, number)

    def _on_sigint(self) -> None:
        again = ' again, ignoring...' if self._interrupted else ''
        self._say('WARNING', 'launch', f'user interrupted with ctrl-c (SIGINT){again}')
        self._interrupted = True
        self._emit(events.Shutdown('ctrl-c (SIGINT)', due_to_sigint=True))
        self._settle()
        self._end_if_idle()

    def _on_sigterm(self, number: int) -> None:
        name = signal.Signals(number).name
        self._say('ERROR', 'launch', f'ended by {name}')
        self._ended_by = number
        self._emit(events.Shutdown(name))
        self._settle()
        self._end_if_idle()

    def _shut_down(self, *, due_to_sigint: bool) -> None:
        """Interrupt all programs, and be stricter with those that do not end."""
        self._managed.abandon('shutdown')
        for handle, timer in list(self._timers.items()):
            if timer.cancel_on_shutdown:
                handle.cancel()
                del self._timers[handle]
        for program in list(self._programs):
            if program.popen is None:  # it was to be started again
                for waiting in program.timers:
                    waiting.cancel()
                self._programs.remove(program)
                continue
            self._end(program, said=not (due_to_sigint and self._interactive))

    def _end(self, program: _Program, *, said: bool) -> None:
        """Interrupt a program, and be stricter with it if it does not end."""
        self._signal(program, signal.SIGINT, said=said)
        program.ending = True
        start = program.start
        first, second = start.sigterm, start.sigterm + start.sigkill
        for seconds, sent, following in (
            (first, signal.SIGINT, signal.SIGTERM),
            (second, signal.SIGTERM, signal.SIGKILL),
        ):
            timer = self._loop.call_later(
                seconds, self._escalate, program, seconds, sent, following
            )
            program.timers.append(timer)

    def _escalate(
        self, program: _Program, seconds: float, sent: signal.Signals, number: signal.Signals
    ) -> None:
        name = program.start.name
        self._say(
            'ERROR',
            name,
            f"process[{name}] failed to terminate '{seconds:g}' seconds after receiving "
            f"'{sent.name}', escalating to '{number.name}'",
        )
        self._signal(program, number, said=True)

    def _signal(self, program: _Program, number: signal.Signals, *, said: bool) -> None:
        name = program.start.name
        if said:
            self._say('INFO', name, f"sending signal '{number.name}' to process[{name}]")
        program.send(number)

    def _end_if_idle(self) -> None:
        if self._programs or self._timers or self._done.done():
            return
        if not self._shutting_down:
            self._emit(events.Shutdown('idle'))
            self._settle()
            self._end_if_idle()
            return
        self._done.set_result(None)

    def _kill_all(self) -> None:
        for program in self._programs:
            if program.popen is not None:
                program.send(signal.SIGKILL)
                program.popen.wait()

    def _open_log(self, stack: contextlib.ExitStack) -> None:
        """Open the log file, if there is a place for it."""
        home = os.environ.get('ROS_HOME') or os.path.expanduser('~/.ros')
        parent = os.environ.get('ROS_LOG_DIR') or os.path.join(home, 'log')
        now = f'{time.strftime("%Y-%m-%d-%H-%M-%S")}-{time.time_ns() // 1000 % 10**6:06}'
        folder = Path(parent, f'{now}-{socket.gethostname()}-{os.getpid()}')
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True)
            self._log = stack.enter_context((folder / 'launch.log').open('w', encoding='utf-8'))
            self._context.log_dir = str(folder)
            text = f'All log files can be found below {folder}'
            self._write(f'[INFO] [launch]: {text}', shown=not self._quiet)

    def _say(self, level: str, who: str, text: str) -> None:
        self._write(f'[{level}] [{who}]: {text}', shown=True)

    def _write(self, line: str, *, shown: bool) -> None:
        if shown:
            print(line, flush=True)
        if self._log is not None:
            self._log.write(f'{time.time():.7f} {line}\n')
            self._log.flush()


def _handled(handler: BaseEventHandler, event: events.Event, context: Context) -> Any:
    """Return what a handler, which may be of somebody's own class, wants to be visited."""
    return handler.handle(event, context) if handler.matches(event) else None


def _on_its_own() -> None:
    """Make a program independent of this one's signals, but not of its end."""
    os.setpgid(0, 0)
    # A shell that starts this in the background may let it ignore Ctrl-C.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
