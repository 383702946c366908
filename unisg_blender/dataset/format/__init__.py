"""A dataset on disk: schema, columns, shards, reader and writer."""
