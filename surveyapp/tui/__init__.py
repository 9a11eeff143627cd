"""Terminal screens: what a surveyor sees and types. No arithmetic: numbers come from the API."""
