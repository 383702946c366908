"""What every room leans on and none is about: progress, files written whole, locks, pools, ONNX sessions."""
