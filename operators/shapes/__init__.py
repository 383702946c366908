"""Where the shapes of new things come from: what the user chose, what is marked as an asset here or in a library."""
