"""What an office files: the ledger, seals, closings, snapshots, and the lock of a folder."""
