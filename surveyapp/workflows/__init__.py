"""What needs several steps below one command: read, compute, write. The API calls them."""
