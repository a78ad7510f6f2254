"""The review page: one offline HTML file for each flight or campaign."""
