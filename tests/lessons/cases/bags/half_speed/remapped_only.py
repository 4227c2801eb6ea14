import labkit as lab

names = {'/cmd_vel': '/slow/cmd_vel'}
with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording:
    playing = lab.play('bags/commands', '/cmd_vel', remap=names, paused=True)
    lab.wait_until(lambda: '/slow/cmd_vel' in recording.counts)
    playing.resume()
    recording.wait_for(30)
