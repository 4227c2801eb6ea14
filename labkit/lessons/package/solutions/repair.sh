# In the editor, in ros2_ws/src/broken_lab/setup.py: a comma, and main. The same by a command:
cd ros2_ws
sed -i "s/teller:main'/teller:main',/; s/hearer:mian/hearer:main/" src/broken_lab/setup.py
# In a terminal, in ros2_ws:
colcon build --packages-select broken_lab
source install/setup.bash
ros2 run broken_lab teller > teller.log 2>&1 &
# In the second terminal, in ros2_ws, after: source install/setup.bash
ros2 run broken_lab hearer > hearer.log 2>&1 &
