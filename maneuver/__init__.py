"""The command line: a file a verb; the only folder that joins the stages."""
