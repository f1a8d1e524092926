"""One HTML file that shows result rows: tables, heatmaps, curves, episodes, walks; no network."""
