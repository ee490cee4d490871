"""Alarms: limits of fields of topics, latched and acknowledged, and one log of all that a run says. No ROS in here."""
