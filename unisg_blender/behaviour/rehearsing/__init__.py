"""A hand that performs a lesson, to show it and to prove that it can be played."""
