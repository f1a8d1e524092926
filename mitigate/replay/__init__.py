"""Run agents on recorded drives and measure how corruptions change their decisions."""
