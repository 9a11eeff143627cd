"""Results as rows of text: pure functions that a test can read without a screen."""
