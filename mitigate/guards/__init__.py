"""What stands between inputs and an agent at run time: restored frames and checked instructions."""
