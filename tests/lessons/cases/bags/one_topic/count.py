import labkit as lab

recording = lab.record(
    'bags/temperature', ['temperature'], storage='sqlite3', overwrite=True, count=30
)
lab.wait_until(lambda: recording.done)
