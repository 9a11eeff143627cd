"""What nature and the instruments do: forward models, effects, instrument cards, rule books.

Needs numpy and the standard library only, opens no file, prints nothing and knows no clock: what
is done with observations stands in the package ``surveyapp``.
"""
