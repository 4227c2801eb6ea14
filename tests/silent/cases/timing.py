"""Time, see `labkit.silent.timing_faults`."""

_SIM = "parameter_overrides=[Parameter('use_sim_time', value=True)]"
_CLOCK = (
    f"n = node('sleepy', {_SIM}); p = loud('clock', '/clock', Clock)\n"
    'def at(sec):\n'
    '    c = Clock(); c.clock.sec = sec; p.publish(c)\n'
    '    lab.wait_until(lambda: n.get_clock().now().nanoseconds == sec * 10**9, timeout_sec=20)\n'
    '    look()\n'
)
_ODOMETRY = "m = stamped(Odometry); m.child_frame_id = 'base_link'; m.header.stamp.sec {change}\n"
_TWO = (
    "n = deaf('listener', 'odom', Odometry, {options}); loud('clock', '/clock', Clock)\n"
    "say(stamped(Odometry), 'odom')"
)
_LONG = (
    "n = node('sleeper'); m = node('other'); {more}\n"
    'def tick(): time.sleep({seconds})\n'
    'n.create_timer(0.01, tick)\n'
    'e = runtime.entry_of(n)\nlab.wait_until(lambda: e.took or {seconds} < 1 and e.counts)'
)
_OVERRUN = (
    "n = node('sleeper')\ndef tick(): time.sleep({seconds})\nn.create_timer({period}, tick)\n"
    'lab.wait_until(lambda: runtime.entry_of(n).callbacks > 3)'
)
# Once `e` has a callback that took long, it is none that outlasts its period.
_QUIET = (
    '\ndef quiet():\n'
    "    assert not [f for f in watch.look() if f.kind.id == 'time.overrun']\n"
    '    return e.took\n'
    'lab.wait_until(quiet)'
)
# A timer and a subscription whose callbacks have one name, as all lambdas have.
_ONE_NAME = (
    "\nm = deaf('worker', 'work', callback=lambda _: time.sleep(0.4)); e = runtime.entry_of(m)\n"
    "m.create_timer(0.05, lambda: None); loud('boss', 'work').publish(String())"
)
_ONE_CALL = (
    "\nm = node('once'); e = runtime.entry_of(m); late = [0.4]\n"
    'm.create_timer(0.05, lambda: time.sleep(late.pop() if late else 0.0))'
)
# As on a machine that lets others run all the while.
_BUSY = (
    '\nfrom labkit.background import executor\n'
    'executor._waits_for_a_processor, real = time.monotonic, executor._waits_for_a_processor\n'
    f'{_OVERRUN.partition("lab.wait_until")[0].format(period=0.05, seconds=0.25)}'
    'lab.wait_until(lambda: runtime.entry_of(n).callbacks > 2)\n'
    'told = [f.kind.id for f in watch.look()]\n'
    'executor._waits_for_a_processor = real; lab.remove(n)\n'
    "assert 'time.overrun' not in told"
)

CASES = {
    'time.no-clock': (
        f"node('sleepy', {_SIM}).create_timer(0.1, heard)",
        f"node('sleepy', {_SIM}).create_timer(0.1, heard); loud('clock', '/clock', Clock)",
    ),
    'time.two-clocks': (_TWO.format(options=_SIM), _TWO.format(options='')),
    'time.jumped-back': (f'{_CLOCK}at(100); at(5)', f'{_CLOCK}at(5); at(100)'),
    'time.future': (
        _ODOMETRY.format(change='+= 60') + 'say(m)',
        _ODOMETRY.format(change='-= 60') + 'say(m)',
    ),
    'time.other-clock': (
        _ODOMETRY.format(change='= 12345') + 'say(m)',
        _ODOMETRY.format(change='-= 3600') + 'say(m)',
    ),
    'time.period-zero': (
        "node('busy').create_timer(0.0, heard)",
        "n = node('once'); n.create_timer(0.0, heard).cancel()",
    ),
    'time.milliseconds': (
        "node('slow').create_timer(500, heard)",
        "node('slow').create_timer(0.5, heard)",
    ),
    'time.rate': ("node('slow').create_timer(30, heard)", "node('slow').create_timer(3, heard)"),
    'time.long-callback': (
        _LONG.format(seconds=1.1, more='m.create_timer(0.5, heard)'),
        _LONG.format(seconds=0.001, more='m.create_timer(0.5, heard)'),
    ),
    'time.overrun': (
        _OVERRUN.format(period=1 / 30, seconds=0.05),
        _OVERRUN.format(period=1, seconds=0.05) + _ONE_NAME + _QUIET + _ONE_CALL + _QUIET + _BUSY,
    ),
    'time.stuck-callback': (
        "free = threading.Event(); n = node('stuck'); begun = threading.Event()\n"
        'def tick(): begun.set(); free.wait()\n'
        'n.create_timer(0.01, tick); begun.wait(); time.sleep(2.1)',
        "free.set(); n = node('quick'); n.create_timer(0.01, heard)",
    ),
}
