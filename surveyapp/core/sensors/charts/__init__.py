"""Pictures of sensor results, as values: what is drawn, not how."""
