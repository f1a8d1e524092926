"""An HTML report of result rows in one file: tables, heatmaps, curves, episodes, trajectories."""
