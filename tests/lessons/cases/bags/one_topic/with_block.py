import labkit as lab

with lab.record(
    'bags/temperature', '/temperature', storage='sqlite3', overwrite=True
) as recording:
    recording.wait_for(25)
