"""Write an HTML report in one file, with tables, heatmaps, curves, episodes and trajectories."""
