"""What is marked as an asset: in this file, and in the files of the asset libraries."""
