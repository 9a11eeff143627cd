"""What the screens for sensors ask: logs and cards, tasks on a log, guided programmes."""
