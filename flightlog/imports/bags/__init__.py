"""Messages of MCAP files and ROS bags, read one after another."""
