"""Many rooms, and many pictures, of the scene that is open: in processes of their own."""
