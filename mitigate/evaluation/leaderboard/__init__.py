"""The leaderboard: entries as JSON, computed from rows, checked against them, shown as a page."""
