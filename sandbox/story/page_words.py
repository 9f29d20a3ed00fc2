"""Words of pages. Scripts read a word by its key with `say(key)`, and the document reads it with a `data-say`
attribute.

Translations are in the same catalogues as the translations of the window. {one}, {many}, {the}, {those} and {a} are
replaced by words for the bodies of the page. If the name in braces has a capital, the word has one as well.
`sandbox/story/page_story.py` writes the words into the page.
"""

from softcradle.sandbox.languages import N_, NP_

WORDS: dict[str, str] = {
    # Words of the buttons and the clock.
    "play": N_("Play"),
    "pause": N_("Pause"),
    "again": N_("Restart"),
    "back": N_("One step back"),
    "ahead": N_("One step forward"),
    "time": N_("Time of the motion"),
    "pace": N_("Playback speed"),
    "slower": N_("{n} × slower"),
    "faster": N_("{n} × faster"),
    "usual": N_("Normal speed"),
    "copied": N_("Copied"),
    "language": N_("Language"),
    "wait": N_("Computing …"),
    # Words of the settings.
    "beside": N_("Compare with"),
    "compare steel": N_("Compare with steel balls"),
    "compare soft": N_("Compare with soft beads"),
    "alone": N_("End comparison"),
    "settings": N_("Settings"),
    "law": N_("Contacts"),
    "scene": N_("Original contacts"),
    "alpha": N_("Softness (exponent α)"),
    "alpha upper": N_("Softness of the soft row (exponent α)"),
    "softest": N_("soft"),
    "hardest": N_("like steel"),
    "strikers": N_("{Those} that hit them"),
    "targets": N_("{Those} at rest"),
    "speed": N_("Speed"),
    "friction": N_("Ground friction"),
    "loss": N_("Energy lost in each contact"),
    "show": N_("Show"),
    "forces": N_("forces"),
    "loupes": N_("magnifiers"),
    "balance": N_("energy and momentum bars"),
    "charts": N_("graphs"),
    # Names of the contact laws of a chain.
    "law soft": N_("soft {many}, alpha = {alpha}"),
    "law one": N_("springs, alpha = 1"),
    "law gear": N_("draft gears"),
    "law steel": N_("steel balls"),
    "law mixed": N_("mixed contacts"),
    # Words of the stage with the beads, the magnified insets and the graphs.
    "force": N_("contact force ({unit})"),
    "hollow": N_("hollow: pulls"),
    "dark": N_("dark: solid"),
    "rigid": N_("if each group were one solid block"),
    "to scale": N_("drawn to scale"),
    "magnified": N_("overlaps enlarged {factor}"),
    "energy bar": N_("energy: kinetic (coloured), stored in contacts (grey)"),
    "energy brief": N_("energy; in contacts: grey"),
    "energy short": N_("energy"),
    "energy lossy": N_("energy: kinetic (coloured), stored in contacts (grey), absorbed"),
    "energy lossy brief": N_("energy; in contacts: grey; absorbed"),
    "momentum bar": N_("momentum (grey mark: zero, black mark: total)"),
    "momentum short": N_("momentum"),
    "overlap of": N_("overlap δ{contact}"),
    "seen at": N_("magnified {factor}"),
    "velocities": N_("Velocities (m/s)"),
    "forces chart": N_("Forces ({unit})"),
    "chart values": N_("The values are under “In numbers” below."),
    # States of a contact. The word for an open contact is in WORDS_IN_CONTEXT.
    "touching": N_("touching"),
    "pulled": N_("pulled"),
    "loaded": N_("pressed"),
    # Words of the energy balance below the stage.
    "energy": N_("Total energy {value}"),
    "absorbed": N_("{value} of it absorbed"),
    "right": N_("conserved to {digits} digits"),
    "right lossy": N_("the sum is kept to {digits} digits"),
    "given": N_("you added {value}"),
    "units": N_("the units are made up"),
    # Sentences around the stage with the beads. The sentences about the outcome are in sentences.py.
    "hint": N_("Try it: drag {a} and let go."),
    "if rigid": N_("Two solid blocks would move at {left} and {right}."),
    "followed": N_("The motion is shown up to {time}."),
    "refused": N_(
        "Your browser or this website blocks WebAssembly. A recording plays instead; dragging and settings are off."
    ),
    "recorded": N_("This is a recording: you can play and rewind it, but not change it."),
    "unmet": N_("This link asks for {list}, which this page cannot do."),
    "here": N_(" (here {value})"),
    "other numbers": N_("You changed the settings, so the original explanation no longer fits. Press play and see."),
    "changed": N_("{title} (changed)"),
    "changed from": N_("{now} (changed from: {title})"),
    "one on": N_("One {one} on {n}"),
    "many on": N_("{m} {many} on {n}"),
    "count": N_("one two three four five six seven eight nine ten eleven twelve"),
    "lead one": N_("In Newton's cradle only the last ball flies off."),
    "lead many": N_("In Newton's cradle as many balls fly off as came."),
    "lead soft": N_("How will these soft beads move?"),
    "lead gear": N_("How will these draft gears move?"),
    "lead steel": N_("How many of these balls will fly off?"),
    "send file": N_(
        "This page is a file on your device. Send the file, and tell others to add this after its name: {text}"
    ),
    "send alone": N_("This page is a file on your device. Send the file itself: nothing in it has been changed."),
    # Words of the question, the answer and the explanation above the beads.
    "guess last": N_("Only the last one flies off"),
    "guess last many": N_("As many fly off as came"),
    "guess together": N_("All move off together"),
    "guess spread": N_("Each goes at its own speed"),
    "guess right": N_("You were right."),
    "guess wrong": N_("Not quite."),
    "verdict last": N_("Only the last one flew off."),
    "verdict last many": N_("As many {many} flew off as came."),
    "verdict spread": N_("They spread out, each at its own speed."),
    "verdict together": N_("{K} of the {n} {many} moved off together, like one solid block."),
    "verdict together all": N_("All {n} {many} moved off together, like one solid block."),
    "steel last": N_("In a steel cradle only the last one does."),
    "steel last many": N_("In a steel cradle as many fly off as came."),
    "explain": N_("Why?"),
    "the contacts": N_("the contacts"),
    "contacts named": N_("contacts {names}"),
    "pushes": N_("Squeezed by {depths}, {contacts} push with {forces} of the force."),
    "pushes still": N_("Squeezed by {depths}, {contacts} still push with {forces} of the force."),
    "so evanescent": N_("So the push reaches the last bead at once, without a wave: an evanescent mode."),
    "so solid": N_("So the push reaches the end of the row at once, as in a solid block."),
    "so wave": N_("So the push runs along the row as a wave."),
    "ghost": N_("grey: before"),
    # Words for sharing a page and for handing in answers.
    "share": N_("Share"),
    "share link": N_("Link with your settings"),
    "share code": N_("Code for a web page"),
    "qr": N_("QR code of the link"),
    "hand in": N_("Hand in"),
    "save csv": N_("Table (CSV)"),
    "save png": N_("Picture (PNG)"),
    "csv text": N_("Table to copy, if downloads are blocked"),
    "copy": N_("Copy"),
    "close": N_("Close"),
    "full": N_("Open the full page"),
    # Words of the tables of numbers.
    "in numbers": N_("In numbers"),
    "contact": N_("contact"),
    "mass": N_("mass (kg)"),
    "now": N_("now (m/s)"),
    "before": N_("at the start (m/s)"),
    "force now": N_("force (N)"),
    "overlap now": N_("overlap (m)"),
    "state": N_("state"),
    "wall": N_("wall"),
    # Words for keyboard and touch control, and for the footer.
    "beads": N_("The {many} of {name}."),
    "bead keys": N_(
        "Arrow keys choose one, Enter grabs or releases it; while held, arrows pull it; Shift with an arrow throws it."
    ),
    "chosen": N_("{the} {bead}, {speed}"),
    "keys": N_("Keys and touch"),
    "help": N_("Space plays and pauses, comma and full stop step, R restarts. The slider below the picture rewinds."),
    "help live": N_(
        "Drag {a} sideways, by mouse or finger, and let go to throw it. With the keyboard: Tab to the "
        "picture, arrow keys to choose one, Enter to grab it, arrow keys to pull, Enter to let go; Shift "
        "with an arrow key throws it at once. The last minute is kept."
    ),
    "file": N_("Scene file (for the softcradle program)"),
    "made": N_("made with"),
}

# Words whose translation depends on the context. Such words are the objects of "Compare with" and the word for an open
# contact.
WORDS_IN_CONTEXT: dict[str, dict[str, str]] = {
    "compare with": {
        "none": NP_("compare with", "nothing"),
        "steel": NP_("compare with", "steel balls"),
        "soft": NP_("compare with", "soft beads"),
        "gear": NP_("compare with", "draft gears"),
    },
    "contact": {"open": NP_("contact", "apart")},
}
