"""Procedural apartments, rendered in software by Panda3D: layouts, episodes, simulator."""
