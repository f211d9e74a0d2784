"""Programs that carry what raylocd publishes into other systems."""
