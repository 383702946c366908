"""The room that is open: what is recognised of its building, corrected and drawn, and its check."""
