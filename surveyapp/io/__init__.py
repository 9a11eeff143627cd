"""Project folders, field books, cards, foreign formats: the border where input is checked."""
