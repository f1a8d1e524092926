"""Procedurally generated apartments: layouts, episodes and a simulator that renders on the CPU with
Panda3D.
"""
