// What the page says, in English, German and French; {names} are filled in.

const WORDS = {
  en: {
    play: "Play", pause: "Pause", again: "Begin again", back: "A step back", ahead: "A step on", time: "Time of the motion",
    pace: "Pace", slower: "{n} × slower", faster: "{n} × faster", usual: "as the scene",
    beside: "Compare with", none: "nothing", steel: "steel balls", soft: "soft beads", gear: "draft gears", "compare steel": "Compare with steel balls",
    alone: "End comparison", link: "Copy link", copied: "Copied", language: "Language",
    settings: "The row", law: "Contacts", scene: "as in the scene", alpha: "Softness α", "alpha upper": "Softness α, upper row", strikers: "Beads that come", targets: "Beads that wait",
    speed: "Speed", friction: "Friction of the ground", loss: "Energy lost in contacts", show: "Show",
    forces: "forces", loupes: "loupes", balance: "energy, momentum", charts: "curves",
    "law soft": "alpha = {alpha}", "law one": "springs, alpha = 1", "law gear": "draft gears", "law steel": "steel balls", "law mixed": "mixed contacts",
    force: "contact force ({unit})", hollow: "hollow: pulls", dark: "dark: solid", rigid: "if clusters were rigid", "to scale": "drawn to scale", magnified: "overlaps drawn {factor}",
    "energy bar": "energy: motion of each bead, stored in contacts (grey)", "energy brief": "energy of beads, contacts (grey)",
    "energy lossy": "energy: motion of each bead, stored in contacts (grey), absorbed", "energy lossy brief": "energy of beads, contacts (grey), absorbed",
    "momentum bar": "momentum of each bead; marks: zero and total",
    "overlap of": "overlap δ{contact}", "seen at": "seen at {factor}", open: "apart", touching: "touching", pulled: "pulled", loaded: "pressed",
    velocities: "Velocities (m/s)", "forces chart": "Forces ({unit})", hint: "Drag a bead and throw it.",
    energy: "Energy {value} J", right: "balanced to {error}", given: "{value} J by hand",
    "two of": "{first} and {last}", "row of": "{first} to {last}", "from to": "{low} to {high}",
    "bead right": "Bead {beads} goes to the right at {speed} m/s.", "beads right": "Beads {beads} go together to the right at {speed} m/s.",
    "bead left": "Bead {beads} goes to the left at {speed} m/s.", "beads left": "Beads {beads} go together to the left at {speed} m/s.",
    "wall right": "Wall {beads} goes to the right at {speed} m/s.", "wall left": "Wall {beads} goes to the left at {speed} m/s.",
    "bead still": "Bead {beads} nearly stands still.", "beads still": "Beads {beads} nearly stand still.", "more groups": "And {n} more groups.",
    "if rigid": "Two rigid bodies: {left} and {right} m/s.", "in numbers": "In numbers", bead: "bead", contact: "contact", mass: "mass (kg)", now: "now (m/s)", before: "at the start (m/s)",
    "force now": "force (N)", "overlap now": "overlap (m)", state: "state", wall: "wall",
    beads: "The beads of {name}.", "bead keys": "Arrow keys choose a bead, Enter takes and leaves it, arrows then pull; Shift with an arrow throws it.",
    chosen: "bead {bead}, {speed} m/s", refused: "This browser or web host does not let the page compute (WebAssembly); what was recorded plays instead.",
    "other numbers": "You have changed this scene: its text was written for other numbers. Play it and see.",
    recorded: "This motion was recorded; it cannot be changed here.", keys: "Keys and touch", file: "The scene as a file: softcradle play FILE lets you change it", made: "made with",
    help: "Space plays and pauses, comma and full stop step, R begins again. The line below the beads winds back.",
    "help live": "Drag a bead, by mouse or finger, and let go to throw it. With the keyboard: Tab to the beads, arrow keys to choose one, Enter to take it, arrow keys to pull, Enter to let go; Shift with an arrow key throws it at once. The last minute is kept.",
  },
  de: {
    play: "Abspielen", pause: "Anhalten", again: "Von vorn", back: "Einen Schritt zurück", ahead: "Einen Schritt weiter", time: "Zeit der Bewegung",
    pace: "Tempo", slower: "{n} × langsamer", faster: "{n} × schneller", usual: "wie die Szene",
    beside: "Vergleichen mit", none: "nichts", steel: "Stahlkugeln", soft: "weichen Kugeln", gear: "Federapparate", "compare steel": "Mit Stahlkugeln vergleichen",
    alone: "Vergleich beenden", link: "Link kopieren", copied: "Kopiert", language: "Sprache",
    settings: "Die Reihe", law: "Kontakte", scene: "wie in der Szene", alpha: "Weichheit α", "alpha upper": "Weichheit α, obere Reihe", strikers: "Kugeln, die kommen", targets: "Kugeln, die warten",
    speed: "Geschwindigkeit", friction: "Reibung am Boden", loss: "Energieverlust in Kontakten", show: "Zeigen",
    forces: "Kräfte", loupes: "Lupen", balance: "Energie, Impuls", charts: "Kurven",
    "law soft": "alpha = {alpha}", "law one": "Federn, alpha = 1", "law gear": "Federapparate", "law steel": "Stahlkugeln", "law mixed": "gemischte Kontakte",
    force: "Kontaktkraft ({unit})", hollow: "hohl: zieht", dark: "dunkel: starr", rigid: "wären die Gruppen starr", "to scale": "maßstäblich", magnified: "Überlappungen {factor}",
    "energy bar": "Energie: Bewegung jeder Kugel, in Kontakten gespeichert (grau)", "energy brief": "Energie der Kugeln, Kontakte (grau)",
    "energy lossy": "Energie: Bewegung jeder Kugel, in Kontakten (grau), verloren", "energy lossy brief": "Energie: Kugeln, Kontakte (grau), verloren",
    "momentum bar": "Impuls jeder Kugel; Striche: null und Summe",
    "overlap of": "Überlappung δ{contact}", "seen at": "gezeigt {factor}", open: "getrennt", touching: "berühren sich", pulled: "gezogen", loaded: "gedrückt",
    velocities: "Geschwindigkeiten (m/s)", "forces chart": "Kräfte ({unit})", hint: "Zieh an einer Kugel und wirf sie.",
    energy: "Energie {value} J", right: "Bilanz auf {error} genau", given: "{value} J von Hand",
    "two of": "{first} und {last}", "row of": "{first} bis {last}", "from to": "{low} bis {high}",
    "bead right": "Kugel {beads} läuft mit {speed} m/s nach rechts.", "beads right": "Kugeln {beads} laufen zusammen mit {speed} m/s nach rechts.",
    "bead left": "Kugel {beads} läuft mit {speed} m/s nach links.", "beads left": "Kugeln {beads} laufen zusammen mit {speed} m/s nach links.",
    "wall right": "Wand {beads} läuft mit {speed} m/s nach rechts.", "wall left": "Wand {beads} läuft mit {speed} m/s nach links.",
    "bead still": "Kugel {beads} steht fast still.", "beads still": "Kugeln {beads} stehen fast still.", "more groups": "Und {n} weitere Gruppen.",
    "if rigid": "Zwei starre Körper: {left} und {right} m/s.", "in numbers": "In Zahlen", bead: "Kugel", contact: "Kontakt", mass: "Masse (kg)", now: "jetzt (m/s)", before: "am Anfang (m/s)",
    "force now": "Kraft (N)", "overlap now": "Überlappung (m)", state: "Zustand", wall: "Wand",
    beads: "Die Kugeln von {name}.", "bead keys": "Pfeiltasten wählen eine Kugel, Eingabe nimmt sie und lässt sie los, Pfeile ziehen dann; Umschalt mit einem Pfeil wirft sie.",
    chosen: "Kugel {bead}, {speed} m/s", refused: "Dieser Browser oder Webserver lässt die Seite nicht rechnen (WebAssembly); stattdessen läuft die Aufzeichnung.",
    "other numbers": "Diese Szene ist geändert: ihr Text galt anderen Zahlen. Abspielen und sehen.",
    recorded: "Diese Bewegung wurde aufgezeichnet und lässt sich hier nicht ändern.", keys: "Tasten und Finger", file: "Die Szene als Datei: softcradle play DATEI lässt sie ändern", made: "erstellt mit",
    help: "Die Leertaste spielt und hält an, Komma und Punkt gehen schrittweise, R beginnt von vorn. Die Zeitleiste unter den Kugeln geht zurück.",
    "help live": "Zieh mit Maus oder Finger an einer Kugel und lass los, um sie zu werfen. Mit der Tastatur: Tab zu den Kugeln, Pfeiltasten wählen, Eingabe nimmt, Pfeiltasten ziehen, Eingabe lässt los; Umschalt mit einer Pfeiltaste wirft sofort. Die letzte Minute bleibt erhalten.",
  },
  fr: {
    play: "Lecture", pause: "Pause", again: "Recommencer", back: "Un pas en arrière", ahead: "Un pas en avant", time: "Temps du mouvement",
    pace: "Allure", slower: "{n} × plus lent", faster: "{n} × plus rapide", usual: "comme la scène",
    beside: "Comparer avec", none: "rien", steel: "billes d'acier", soft: "billes molles", gear: "amortisseurs", "compare steel": "Comparer avec l'acier",
    alone: "Fin de comparaison", link: "Copier le lien", copied: "Copié", language: "Langue",
    settings: "La rangée", law: "Contacts", scene: "comme la scène", alpha: "Mollesse α", "alpha upper": "Mollesse α, rangée du haut", strikers: "Billes qui arrivent", targets: "Billes qui attendent",
    speed: "Vitesse", friction: "Frottement du sol", loss: "Énergie perdue aux contacts", show: "Montrer",
    forces: "forces", loupes: "loupes", balance: "énergie, impulsion", charts: "courbes",
    "law soft": "alpha = {alpha}", "law one": "ressorts, alpha = 1", "law gear": "amortisseurs", "law steel": "billes d'acier", "law mixed": "contacts divers",
    force: "force de contact ({unit})", hollow: "creux : tire", dark: "sombre : rigide", rigid: "si les groupes étaient rigides", "to scale": "à l'échelle", magnified: "recouvrements {factor}",
    "energy bar": "énergie : mouvement de chaque bille, stockée aux contacts (gris)", "energy brief": "énergie des billes, contacts (gris)",
    "energy lossy": "énergie : mouvement de chaque bille, contacts (gris), perdue", "energy lossy brief": "énergie : billes, contacts (gris), perdue",
    "momentum bar": "impulsion de chaque bille ; traits : zéro et total",
    "overlap of": "recouvrement δ{contact}", "seen at": "vu {factor}", open: "séparées", touching: "en contact", pulled: "tirées", loaded: "pressées",
    velocities: "Vitesses (m/s)", "forces chart": "Forces ({unit})", hint: "Tirez une bille et lancez-la.",
    energy: "Énergie {value} J", right: "bilan juste à {error}", given: "{value} J à la main",
    "two of": "{first} et {last}", "row of": "{first} à {last}", "from to": "{low} à {high}",
    "bead right": "La bille {beads} va vers la droite à {speed} m/s.", "beads right": "Les billes {beads} vont ensemble vers la droite à {speed} m/s.",
    "bead left": "La bille {beads} va vers la gauche à {speed} m/s.", "beads left": "Les billes {beads} vont ensemble vers la gauche à {speed} m/s.",
    "wall right": "Le mur {beads} va vers la droite à {speed} m/s.", "wall left": "Le mur {beads} va vers la gauche à {speed} m/s.",
    "bead still": "La bille {beads} s'arrête presque.", "beads still": "Les billes {beads} s'arrêtent presque.", "more groups": "Et {n} autres groupes.",
    "if rigid": "Deux corps rigides : {left} et {right} m/s.", "in numbers": "En nombres", bead: "bille", contact: "contact", mass: "masse (kg)", now: "maintenant (m/s)", before: "au début (m/s)",
    "force now": "force (N)", "overlap now": "recouvrement (m)", state: "état", wall: "mur",
    beads: "Les billes de {name}.", "bead keys": "Les flèches choisissent une bille, Entrée la prend et la lâche, les flèches la tirent alors ; Maj avec une flèche la lance.",
    chosen: "bille {bead}, {speed} m/s", refused: "Ce navigateur ou ce serveur ne laisse pas la page calculer (WebAssembly) ; l'enregistrement est joué à la place.",
    "other numbers": "Cette scène est modifiée : son texte valait pour d'autres nombres. La jouer pour voir.",
    recorded: "Ce mouvement a été enregistré ; il ne peut pas être changé ici.", keys: "Touches et doigts", file: "La scène en fichier : softcradle play FICHIER permet de la changer", made: "fait avec",
    help: "Espace lit et arrête, virgule et point avancent pas à pas, R recommence. La ligne sous les billes remonte le temps.",
    "help live": "Tirez une bille à la souris ou au doigt et lâchez pour la lancer. Au clavier : Tab jusqu'aux billes, flèches pour choisir, Entrée pour prendre, flèches pour tirer, Entrée pour lâcher ; Maj avec une flèche lance tout de suite. La dernière minute est gardée.",
  },
};

let words = WORDS.en;

// The language of a code as a browser gives it, of those that there are; English for any other.
const knownLanguage = (code) => Object.keys(WORDS).find((known) => known === String(code).slice(0, 2).toLowerCase()) ?? "en";

function useLanguage(code) {
  words = WORDS[code];
  numberForm.mark = code === "en" ? "." : ",";
  document.documentElement.lang = code;
}

/** @param {string} key @param {Record<string, string|number>} [values] */
const say = (key, values = {}) => words[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name]));
