"""Text: the signs of the font, and lines that fit their room."""

from softcradle.sandbox.draw.text import font, shortened, width, wrapped


def test_the_font_has_every_sign():
    signs = "0123456789δvf₀₁₉₋⁰¹²⁹⁻·\N{MULTIPLICATION SIGN}\N{MINUS SIGN}…✓µ()=!éüα\N{NARROW NO-BREAK SPACE}"
    assert all(metric is not None for metric in font(20).metrics(signs))
    assert len({font(40).size(digit)[0] for digit in "0123456789\N{MINUS SIGN}"}) == 1, (
        "digits have one width, so that changing numbers do not move"
    )


def test_text_fits_its_room():
    assert width(shortened("a rather long title", 20, 100), 20) <= 100
    assert shortened("short", 20, 1000) == "short"
    assert all(width(line, 15) <= 200 for line in wrapped("a b c " * 40, 15, 200))
    assert " ".join(wrapped("one two three", 15, 60)) == "one two three"
