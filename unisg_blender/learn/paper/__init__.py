"""The paper's experiments that train networks; :mod:`unisg_blender.evaluate.paper` plans, keeps and reports them."""
