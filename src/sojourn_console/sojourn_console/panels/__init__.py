"""What stands beside the scene: one kind a module, each with its controls in a tab of the page."""
