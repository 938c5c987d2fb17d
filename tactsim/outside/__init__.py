"""Where tactsim meets what it does not control: files of others, child processes, foreign text, warnings of libraries."""
