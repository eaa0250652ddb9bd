"""JSON schemas of every file a person writes and of every answer in JSON, for editors, checks and other programs.

It reads the cards and laws that there are, users' own included. It knows no run and no command.
"""
