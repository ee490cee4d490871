"""What is drawn in three dimensions: one kind a module, each made from the server and the world, and shown a scene."""
