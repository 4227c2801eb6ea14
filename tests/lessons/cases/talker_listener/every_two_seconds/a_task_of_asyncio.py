import asyncio

import rclpy
from std_msgs.msg import String

import labkit as lab

node = lab.spin(rclpy.create_node('metronome'))
publisher = node.create_publisher(String, 'chatter', 10)


async def tick(publisher):
    while True:
        try:
            publisher.publish(String(data='tick'))
        except Exception:
            return
        await asyncio.sleep(2)


tasks = [asyncio.create_task(tick(publisher))]
