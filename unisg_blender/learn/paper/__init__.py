"""The paper's experiments that train networks; :mod:`unisg_blender.experiments.paper` plans, keeps and reports them."""
