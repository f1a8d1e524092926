"""Procedural apartments rendered in software by Panda3D: layouts, furniture, episodes, simulator."""
