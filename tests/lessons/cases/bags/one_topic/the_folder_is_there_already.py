import labkit as lab

lab.record('bags/temperature', '/temperature').stop()
recording = lab.record('bags/temperature', '/temperature', storage='sqlite3')
recording.wait_for(20)
recording.stop()
