"""Electronic compass forward models."""
