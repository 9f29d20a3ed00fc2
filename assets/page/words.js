// Texts of the page in English, German and French. {names} are filled in; {one}, {many}, {the}, {those} and {a} are words for the bodies.

const WORDS = {
  en: {
    play: "Play", pause: "Pause", again: "Restart", back: "One step back", ahead: "One step forward", time: "Time of the motion",
    pace: "Playback speed", slower: "{n} × slower", faster: "{n} × faster", usual: "Normal speed",
    beside: "Compare with", none: "nothing", steel: "steel balls", soft: "soft beads", gear: "draft gears",
    "compare steel": "Compare with steel balls", "compare soft": "Compare with soft beads",
    alone: "End comparison", link: "Copy link", copied: "Copied", language: "Language",
    settings: "Settings", law: "Contacts", scene: "Original contacts", alpha: "Exponent α (smaller = softer)", "alpha upper": "Exponent α of the soft row (smaller = softer)",
    softest: "soft", hardest: "like steel", strikers: "{Those} that hit them", targets: "{Those} at rest",
    speed: "Speed", friction: "Ground friction", loss: "Energy lost in each contact", show: "Show",
    forces: "forces", loupes: "magnifiers", balance: "energy and momentum bars", charts: "graphs",
    "law soft": "alpha = {alpha}", "law one": "springs, alpha = 1", "law gear": "draft gears", "law steel": "steel balls", "law mixed": "mixed contacts",
    force: "contact force ({unit})", hollow: "hollow: pulls", dark: "dark: solid", rigid: "if each group were one solid block", "to scale": "drawn to scale", magnified: "overlaps enlarged {factor}",
    "energy bar": "energy: kinetic (coloured), stored in contacts (grey)", "energy brief": "energy; in contacts: grey", "energy short": "energy",
    "energy lossy": "energy: kinetic (coloured), stored in contacts (grey), absorbed", "energy lossy brief": "energy; in contacts: grey; absorbed",
    "momentum bar": "momentum (grey mark: zero, black mark: total)", "momentum short": "momentum",
    "overlap of": "overlap δ{contact}", "seen at": "magnified {factor}", open: "apart", touching: "touching", pulled: "pulled", loaded: "pressed",
    velocities: "Velocities (m/s)", "forces chart": "Forces ({unit})", "chart values": "The values are under “In numbers” below.", hint: "Try it: drag {a} and let go.",
    energy: "Total energy {value}", absorbed: "{value} of it absorbed", right: "conserved to {digits} digits", "right lossy": "the sum is kept to {digits} digits",
    given: "you added {value}", units: "the units are made up",
    "two of": "{first} and {last}", "row of": "{first} to {last}",
    "bead right": "{The} {beads} moves right at {speed} m/s.", "beads right": "{Those} {beads} move right together at {speed} m/s.",
    "bead left": "{The} {beads} moves left at {speed} m/s.", "beads left": "{Those} {beads} move left together at {speed} m/s.",
    "wall right": "Wall {beads} moves right at {speed} m/s.", "wall left": "Wall {beads} moves left at {speed} m/s.",
    "bead still": "{The} {beads} is almost at rest.", "beads still": "{Those} {beads} are almost at rest.", "more group": "And {n} more group.", "more groups": "And {n} more groups.",
    "if rigid": "Two solid blocks would move at {left} and {right} m/s.", stopped: "Then friction stopped them.", followed: "The motion is shown up to {time}.",
    "in numbers": "In numbers", contact: "contact", mass: "mass (kg)", now: "now (m/s)", before: "at the start (m/s)",
    "force now": "force (N)", "overlap now": "overlap (m)", state: "state", wall: "wall",
    beads: "The {many} of {name}.", "bead keys": "Arrow keys choose one, Enter grabs or releases it; while held, arrows pull it; Shift with an arrow throws it.",
    chosen: "{the} {bead}, {speed} m/s", wait: "Computing …", refused: "Your browser or this website blocks WebAssembly. A recording plays instead; dragging and settings are off.",
    recorded: "This is a recording: you can play and rewind it, but not change it.", unmet: "This link asks for {list}, which this page cannot do.", here: " (here {value})",
    "other numbers": "You changed the settings, so the original explanation no longer fits. Press play and see.",
    changed: "{title} (changed)", "changed from": "{now} (changed from: {title})", "one on": "One {one} on {n}", "many on": "{m} {many} on {n}",
    count: "one two three four five six seven eight nine ten eleven twelve",
    "lead one": "In Newton's cradle only the last ball flies off.", "lead many": "In Newton's cradle as many balls fly off as came.",
    "lead soft": "What will these soft beads do?", "lead gear": "What will these draft gears do?", "lead steel": "How many of these balls will fly off?",
    "send file": "This page is a file on your device. Send the file, and tell others to add this after its name: {text}", "send alone": "This page is a file on your device. Send the file itself: nothing in it has been changed.",
    keys: "Keys and touch", file: "Scene file (for the softcradle program)", made: "made with",
    help: "Space plays and pauses, comma and full stop step, R restarts. The slider below the picture rewinds.",
    "help live": "Drag {a} sideways, by mouse or finger, and let go to throw it. With the keyboard: Tab to the picture, arrow keys to choose one, Enter to grab it, arrow keys to pull, Enter to let go; Shift with an arrow key throws it at once. The last minute is kept.",
    "bead one": "bead", "bead many": "beads", "bead the": "bead", "bead those": "beads", "bead a": "a bead",
    "wagon one": "wagon", "wagon many": "wagons", "wagon the": "wagon", "wagon those": "wagons", "wagon a": "a wagon",
    "cylinder one": "cylinder", "cylinder many": "cylinders", "cylinder the": "cylinder", "cylinder those": "cylinders", "cylinder a": "a cylinder",
  },
  de: {
    play: "Abspielen", pause: "Anhalten", again: "Von vorn", back: "Einen Schritt zurück", ahead: "Einen Schritt weiter", time: "Zeit der Bewegung",
    pace: "Abspieltempo", slower: "{n} × langsamer", faster: "{n} × schneller", usual: "Normales Tempo",
    beside: "Vergleichen mit", none: "nichts", steel: "Stahlkugeln", soft: "weichen Kugeln", gear: "Federapparaten",
    "compare steel": "Mit Stahlkugeln vergleichen", "compare soft": "Mit weichen Kugeln vergleichen",
    alone: "Vergleich beenden", link: "Link kopieren", copied: "Kopiert", language: "Sprache",
    settings: "Einstellungen", law: "Kontakte", scene: "Ursprüngliche Kontakte", alpha: "Exponent α (kleiner = weicher)", "alpha upper": "Exponent α der weichen Reihe (kleiner = weicher)",
    softest: "weich", hardest: "wie Stahl", strikers: "{Those}, die auftreffen", targets: "{Those} in Ruhe",
    speed: "Geschwindigkeit", friction: "Reibung am Boden", loss: "Energieverlust in jedem Kontakt", show: "Anzeigen",
    forces: "Kräfte", loupes: "Lupen", balance: "Balken für Energie und Impuls", charts: "Diagramme",
    "law soft": "alpha = {alpha}", "law one": "Federn, alpha = 1", "law gear": "Federapparate", "law steel": "Stahlkugeln", "law mixed": "verschiedene Kontakte",
    force: "Kontaktkraft ({unit})", hollow: "hohl: zieht", dark: "dunkel: starr", rigid: "wäre jede Gruppe ein starrer Block", "to scale": "maßstäblich", magnified: "Überlappungen {factor} vergrößert",
    "energy bar": "Energie: Bewegung (farbig), in Kontakten (grau)", "energy brief": "Energie; in Kontakten: grau", "energy short": "Energie",
    "energy lossy": "Energie: Bewegung (farbig), in Kontakten (grau), verloren", "energy lossy brief": "Energie; Kontakte: grau; verloren",
    "momentum bar": "Impuls (graue Marke: null, schwarze Marke: Summe)", "momentum short": "Impuls",
    "overlap of": "Überlappung δ{contact}", "seen at": "{factor} vergrößert", open: "getrennt", touching: "berührt", pulled: "gezogen", loaded: "gedrückt",
    velocities: "Geschwindigkeiten (m/s)", "forces chart": "Kräfte ({unit})", "chart values": "Die Werte stehen unten bei „In Zahlen“.", hint: "Probier es aus: Zieh an {a} und lass los.",
    energy: "Gesamtenergie {value}", absorbed: "davon {value} verloren", right: "auf {digits} Stellen erhalten", "right lossy": "die Summe bleibt auf {digits} Stellen gleich",
    given: "du hast {value} zugeführt", units: "die Einheiten sind erdacht",
    "two of": "{first} und {last}", "row of": "{first} bis {last}",
    "bead right": "{The} {beads} läuft mit {speed} m/s nach rechts.", "beads right": "{Those} {beads} laufen zusammen mit {speed} m/s nach rechts.",
    "bead left": "{The} {beads} läuft mit {speed} m/s nach links.", "beads left": "{Those} {beads} laufen zusammen mit {speed} m/s nach links.",
    "wall right": "Wand {beads} läuft mit {speed} m/s nach rechts.", "wall left": "Wand {beads} läuft mit {speed} m/s nach links.",
    "bead still": "{The} {beads} ist fast in Ruhe.", "beads still": "{Those} {beads} sind fast in Ruhe.", "more group": "Und {n} weitere Gruppe.", "more groups": "Und {n} weitere Gruppen.",
    "if rigid": "Zwei starre Blöcke hätten {left} und {right} m/s.", stopped: "Danach hat die Reibung sie gestoppt.", followed: "Die Bewegung ist bis {time} gezeigt.",
    "in numbers": "In Zahlen", contact: "Kontakt", mass: "Masse (kg)", now: "jetzt (m/s)", before: "am Anfang (m/s)",
    "force now": "Kraft (N)", "overlap now": "Überlappung (m)", state: "Zustand", wall: "Wand",
    beads: "{name}: die {many}.", "bead keys": "Pfeiltasten wählen aus, Eingabe greift oder lässt los; beim Festhalten ziehen die Pfeile; Umschalt mit einem Pfeil wirft.",
    chosen: "{the} {bead}, {speed} m/s", wait: "Wird berechnet …", refused: "Dein Browser oder diese Website sperrt WebAssembly. Stattdessen läuft eine Aufzeichnung; Ziehen und Einstellungen sind aus.",
    recorded: "Das ist eine Aufzeichnung: Du kannst sie abspielen und zurückspulen, aber nicht ändern.", unmet: "Dieser Link verlangt {list}; das kann diese Seite nicht.", here: " (hier {value})",
    "other numbers": "Du hast die Einstellungen geändert, deshalb passt die ursprüngliche Erklärung nicht mehr. Spiel ab und sieh selbst.",
    changed: "{title} (geändert)", "changed from": "{now} (geändert aus: {title})", "one on": "Eine {one} auf {n}", "many on": "{m} {many} auf {n}",
    count: "eine zwei drei vier fünf sechs sieben acht neun zehn elf zwölf",
    "lead one": "Im Kugelstoßpendel fliegt nur die letzte Kugel weg.", "lead many": "Im Kugelstoßpendel fliegen so viele Kugeln weg, wie ankommen.",
    "lead soft": "Was machen diese weichen Kugeln?", "lead gear": "Was machen diese Federapparate?", "lead steel": "Wie viele dieser Kugeln fliegen weg?",
    "send file": "Diese Seite ist eine Datei auf deinem Gerät. Schick die Datei und bitte andere, dies an ihren Namen anzuhängen: {text}", "send alone": "Diese Seite ist eine Datei auf deinem Gerät. Schick die Datei selbst: Es ist nichts geändert.",
    keys: "Tasten und Finger", file: "Szenendatei (für das Programm softcradle)", made: "erstellt mit",
    help: "Die Leertaste spielt ab und hält an, Komma und Punkt gehen schrittweise, R beginnt von vorn. Der Regler unter dem Bild spult zurück.",
    "help live": "Zieh mit Maus oder Finger seitwärts an {a} und lass los, um zu werfen. Mit der Tastatur: mit Tab zum Bild, Pfeiltasten wählen, Eingabe greift, Pfeiltasten ziehen, Eingabe lässt los; Umschalt mit einer Pfeiltaste wirft sofort. Die letzte Minute bleibt erhalten.",
    "bead one": "Kugel", "bead many": "Kugeln", "bead the": "Kugel", "bead those": "Kugeln", "bead a": "einer Kugel",
    "wagon one": "Wagen", "wagon many": "Wagen", "wagon the": "Wagen", "wagon those": "Wagen", "wagon a": "einem Wagen",
    "cylinder one": "Zylinder", "cylinder many": "Zylinder", "cylinder the": "Zylinder", "cylinder those": "Zylinder", "cylinder a": "einem Zylinder",
  },
  fr: {
    play: "Lecture", pause: "Pause", again: "Recommencer", back: "Un pas en arrière", ahead: "Un pas en avant", time: "Temps du mouvement",
    pace: "Vitesse de lecture", slower: "{n} × plus lent", faster: "{n} × plus rapide", usual: "Vitesse normale",
    beside: "Comparer avec", none: "rien", steel: "des billes d'acier", soft: "des billes molles", gear: "des amortisseurs",
    "compare steel": "Comparer avec l'acier", "compare soft": "Comparer avec des billes molles",
    alone: "Fin de la comparaison", link: "Copier le lien", copied: "Copié", language: "Langue",
    settings: "Réglages", law: "Contacts", scene: "Contacts d'origine", alpha: "Exposant α (plus petit = plus mou)", "alpha upper": "Exposant α de la rangée molle (plus petit = plus mou)",
    softest: "mou", hardest: "comme l'acier", strikers: "{Those} qui frappent", targets: "{Those} au repos",
    speed: "Vitesse", friction: "Frottement du sol", loss: "Énergie perdue à chaque contact", show: "Afficher",
    forces: "forces", loupes: "loupes", balance: "barres d'énergie et d'impulsion", charts: "graphiques",
    "law soft": "alpha = {alpha}", "law one": "ressorts, alpha = 1", "law gear": "amortisseurs", "law steel": "billes d'acier", "law mixed": "contacts divers",
    force: "force de contact ({unit})", hollow: "creux : tire", dark: "sombre : rigide", rigid: "si chaque groupe était un bloc rigide", "to scale": "à l'échelle", magnified: "recouvrements agrandis {factor}",
    "energy bar": "énergie : cinétique (couleurs), stockée aux contacts (gris)", "energy brief": "énergie ; contacts : gris", "energy short": "énergie",
    "energy lossy": "énergie : cinétique (couleurs), contacts (gris), perdue", "energy lossy brief": "énergie ; contacts : gris ; perdue",
    "momentum bar": "impulsion (trait gris : zéro, trait noir : total)", "momentum short": "impulsion",
    "overlap of": "recouvrement δ{contact}", "seen at": "agrandi {factor}", open: "ouvert", touching: "en contact", pulled: "tiré", loaded: "pressé",
    velocities: "Vitesses (m/s)", "forces chart": "Forces ({unit})", "chart values": "Les valeurs sont plus bas, sous « En nombres ».", hint: "Essayez : tirez {a} et lâchez.",
    energy: "Énergie totale {value}", absorbed: "dont {value} absorbés", right: "conservée à {digits} chiffres", "right lossy": "somme conservée à {digits} chiffres",
    given: "vous avez ajouté {value}", units: "les unités sont fictives",
    "two of": "{first} et {last}", "row of": "{first} à {last}",
    "bead right": "{The} {beads} part vers la droite à {speed} m/s.", "beads right": "{Those} {beads} partent ensemble vers la droite à {speed} m/s.",
    "bead left": "{The} {beads} part vers la gauche à {speed} m/s.", "beads left": "{Those} {beads} partent ensemble vers la gauche à {speed} m/s.",
    "wall right": "Le mur {beads} part vers la droite à {speed} m/s.", "wall left": "Le mur {beads} part vers la gauche à {speed} m/s.",
    "bead still": "{The} {beads} est presque au repos.", "beads still": "{Those} {beads} sont presque au repos.", "more group": "Et {n} autre groupe.", "more groups": "Et {n} autres groupes.",
    "if rigid": "Deux blocs rigides auraient {left} et {right} m/s.", stopped: "Puis le frottement arrête tout.", followed: "Le mouvement est montré jusqu'à {time}.",
    "in numbers": "En nombres", contact: "contact", mass: "masse (kg)", now: "maintenant (m/s)", before: "au début (m/s)",
    "force now": "force (N)", "overlap now": "recouvrement (m)", state: "état", wall: "mur",
    beads: "{name} : les {many}.", "bead keys": "Les flèches choisissent, Entrée saisit ou lâche ; les flèches tirent alors ; Maj avec une flèche lance.",
    chosen: "{the} {bead}, {speed} m/s", wait: "Calcul en cours…", refused: "Votre navigateur ou ce site bloque WebAssembly. Un enregistrement est joué à la place ; on ne peut ni tirer ni régler.",
    recorded: "C'est un enregistrement : on peut le lire et le rembobiner, pas le modifier.", unmet: "Ce lien demande {list}, ce que cette page ne peut pas faire.", here: " (ici {value})",
    "other numbers": "Vous avez changé les réglages : l'explication d'origine ne convient plus. Lancez la lecture pour voir.",
    changed: "{title} (modifié)", "changed from": "{now} (modifié à partir de : {title})", "one on": "Une {one} contre {n}", "many on": "{m} {many} contre {n}",
    count: "une deux trois quatre cinq six sept huit neuf dix onze douze",
    "lead one": "Dans le pendule de Newton, seule la dernière bille s'envole.", "lead many": "Dans le pendule de Newton, autant de billes s'envolent qu'il en arrive.",
    "lead soft": "Que feront ces billes molles ?", "lead gear": "Que feront ces amortisseurs ?", "lead steel": "Combien de ces billes vont s'envoler ?",
    "send file": "Cette page est un fichier sur votre appareil. Envoyez le fichier, et dites d'ajouter ceci après son nom : {text}", "send alone": "Cette page est un fichier sur votre appareil. Envoyez le fichier lui-même : rien n'y est modifié.",
    keys: "Touches et doigts", file: "Fichier de la scène (pour le programme softcradle)", made: "fait avec",
    help: "Espace lit et arrête, virgule et point avancent pas à pas, R recommence. Le curseur sous l'image remonte le temps.",
    "help live": "Tirez {a} de côté, à la souris ou au doigt, et lâchez pour lancer. Au clavier : Tab jusqu'à l'image, flèches pour choisir, Entrée pour saisir, flèches pour tirer, Entrée pour lâcher ; Maj avec une flèche lance tout de suite. La dernière minute est gardée.",
    "bead one": "bille", "bead many": "billes", "bead the": "la bille", "bead those": "les billes", "bead a": "une bille",
    "wagon one": "wagon", "wagon many": "wagons", "wagon the": "le wagon", "wagon those": "les wagons", "wagon a": "un wagon",
    "cylinder one": "cylindre", "cylinder many": "cylindres", "cylinder the": "le cylindre", "cylinder those": "les cylindres", "cylinder a": "un cylindre",
  },
};

let words = WORDS.en, bodyKind = "bead";

// Return the first of several language codes of a browser that the page has texts for.
function languageIn(codes) {
  const known = Object.keys(WORDS), short = (code) => String(code).slice(0, 2).toLowerCase();
  return codes.map(short).find((code) => known.includes(code));
}

function useLanguage(code) {
  words = WORDS[code];
  numberForm.mark = code === "en" ? "." : ",";
  document.documentElement.lang = code;
}

// Use the words of a `kind` for the bodies. Return true if this is a change.
function useBodies(kind) {
  const other = kind !== bodyKind;
  bodyKind = kind;
  return other;
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// Return a word for the bodies of the page: "one", "many", "the", "those" or "a"; with a capital if `name` has one.
function bodyWord(name) {
  const found = words[`${bodyKind} ${name.toLowerCase()}`] ?? "";
  return name === name.toLowerCase() ? found : capital(found);
}

/** @param {string} key @param {Record<string, string|number>} [values] */
const say = (key, values = {}) => words[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name] ?? bodyWord(name)));
