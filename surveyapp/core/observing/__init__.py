"""What is shown, forecast and asked while a surveyor stands at the instrument."""
