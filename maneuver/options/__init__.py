"""Options and argument types that verbs share."""
