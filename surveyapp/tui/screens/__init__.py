"""One screen a file; a screen arranges widgets and passes messages on, it computes nothing."""
