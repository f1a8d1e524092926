"""The leaderboard, whose JSON entries are computed from rows, checked, and shown as a page."""
