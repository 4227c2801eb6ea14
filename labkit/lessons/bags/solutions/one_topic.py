import labkit as lab

recording = lab.record('bags/temperature', '/temperature', storage='sqlite3', overwrite=True)
recording.wait_for(20)
recording.stop()
