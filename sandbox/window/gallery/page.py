"""The gallery page: sections of scenes, a card with picture, title and text for each scene, and a search field."""

from __future__ import annotations

import contextlib
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import pygame
import pygame_gui
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import ENGLISH, N_, _, language, scene_words
from softcradle.sandbox.window.gallery import thumbnails
from softcradle.sandbox.window.page import Host, Page
from softcradle.sandbox.window.plots.scales import motions_ahead
from softcradle.sandbox.window.widgets import TextEntry
from softcradle.scenes import Scene, SceneError, load, names


class Section(NamedTuple):
    """A section of the gallery: its title and the names of its scenes."""

    title: str
    names: tuple[str, ...]


SECTIONS = (
    Section(N_("Start here"), ("cradle", "one-on-four", "steel-and-soft", "train-shunting")),
    Section(
        N_("The paper"),
        (
            *("one-on-four-softer", "one-on-ten", "two-on-two", "three-on-five", "galilean", "mixed"),
            *("hooke-interface", "weak-contact", "prestressed", "driven-cluster", "stiff-springs"),
            *("experiment-one-on-three", "experiment-two-on-two"),
        ),
    ),
    Section(
        N_("Draft gears"), ("draft-gear-one-on-three", "locked-pistons", "beads-against-gear", "draft-gear-two-on-two")
    ),
    Section(N_("Cradles"), ("hertz-cradle", "hooke-cradle")),
    Section(N_("Trains"), ("train-solid", "train-cut", "train-starting", "train-braking")),
)
REST = N_("More")  # Title above the scenes that belong to no section.
MINE = N_("My scenes")  # Title above the files that were opened or saved last.
FOUND = N_("Found")  # Title above the scenes that match a search.


def sections_of(names: Sequence[str], mine: Sequence[str] = ()) -> list[Section]:
    """Return the sections that contain the scenes `names`.

    The user's files `mine` follow the first section. Scenes that belong to no section come last.
    """
    listed = {name for section in SECTIONS for name in section.names} | set(mine)
    rest = Section(REST, tuple(name for name in names if name not in listed))
    order = (SECTIONS[0], Section(MINE, tuple(mine)), *SECTIONS[1:], rest)
    chosen = [Section(title, tuple(name for name in own if name in names)) for title, own in order]
    return [section for section in chosen if section.names]


def found(captions: Mapping[str, Sequence[str]], search: str) -> list[str]:
    """Return the names of the scenes that match a search. The captions of such a scene contain every searched word.

    The title is the first caption. Scenes with all words in their title come first. Scenes with words that begin with
    the searched words come next.
    """
    words = search.lower().split()

    def rank(name: str) -> tuple[bool, bool]:
        title, text = captions[name][0].lower(), " ".join(captions[name]).lower()
        return not all(word in title for word in words), not all(f" {word}" in f" {text}" for word in words)

    texts = {name: f"{name} {' '.join(caption)}".lower() for name, caption in captions.items()}
    return sorted((name for name, text in texts.items() if all(word in text for word in words)), key=rank)


MARGIN = 34.0  # Margin on the left and right in design pixels.
HEADER = 90.0  # Height of the header in design pixels.
GUTTER = 20.0  # Distance between two cards in design pixels.
COLUMN = 285.0  # Smallest width of a card in design pixels.
CAPTION = 82.0  # Height of the caption below a picture in design pixels.
SECTION_TITLE = 30.0  # Height of a section title in design pixels.
BAR = 10.0  # Width of the scroll bar in design pixels.


class CardGrid:
    """Layout of the cards.

    Attributes:
        columns: number of cards in a row.
        picture_size: size of the picture on each card [pixels].
        scroll: distance by which the page is scrolled down [pixels].
    """

    def __init__(self) -> None:
        self.columns, self.picture_size, self.scroll = 1, (1, 1), 0.0
        self.size, self.unit, self._full, self._grip = (1, 1), 1.0, 1.0, 0.0
        self._cards: list[pygame.Rect] = []
        self._titles: list[tuple[str, float]] = []
        self.dragged = False

    def arrange(self, size: tuple[int, int], unit: float, sections: Sequence[Section]) -> None:
        """Place the cards in a window of `size`."""
        self.size, self.unit = size, unit
        inner = size[0] - 2 * MARGIN * unit
        self.columns = max(1, int((inner + GUTTER * unit) // ((COLUMN + GUTTER) * unit)))
        wide = (inner - (self.columns - 1) * GUTTER * unit) / self.columns
        self.picture_size = round(wide), round(wide * thumbnails.SIZE[1] / thumbnails.SIZE[0])
        high = round(self.picture_size[1] + CAPTION * unit)
        self._cards, self._titles, y = [], [], HEADER * unit
        for section in sections:
            self._titles.append((_(section.title), y))
            y += SECTION_TITLE * unit
            for k in range(len(section.names)):
                row, column = divmod(k, self.columns)
                x = MARGIN * unit + column * (wide + GUTTER * unit)
                place = pygame.Rect(round(x), round(y + row * (high + GUTTER * unit)), self.picture_size[0], high)
                self._cards.append(place)
            y += -(-len(section.names) // self.columns) * (high + GUTTER * unit)
        self._full = y
        self.scroll_by(0.0)

    def place(self, k: int) -> pygame.Rect:
        """Return the rectangle of card `k` on screen."""
        return self._cards[k].move(0, -round(self.scroll))

    def titles(self) -> list[tuple[str, float]]:
        """Return the titles of the sections and their vertical positions on screen."""
        return [(title, y - self.scroll) for title, y in self._titles]

    def card_at(self, point: tuple[int, int]) -> int | None:
        """Return the index of the visible card at `point`, or None."""
        if point[1] < HEADER * self.unit:
            return None
        return next((k for k in range(len(self._cards)) if self.place(k).collidepoint(point)), None)

    def neighbour(self, k: int, by: int) -> int:
        """Return the card nearest to card `k` in the next row below (1) or above (-1), or `k` if there is no such row."""
        here = self._cards[k]
        rows = sorted({card.top for card in self._cards if (card.top - here.top) * by > 0}, reverse=by < 0)
        if not rows:
            return k
        row = [j for j, card in enumerate(self._cards) if card.top == rows[0]]
        return min(row, key=lambda j: abs(self._cards[j].left - here.left))

    def show(self, k: int) -> None:
        """Scroll the page so that card `k` is visible."""
        card = self.place(k)
        top, bottom = (HEADER + SECTION_TITLE) * self.unit, self.size[1] - 10
        if card.top < top:
            self.scroll_by(card.top - top)
        elif card.bottom > bottom:
            self.scroll_by(card.bottom - bottom)

    def scroll_by(self, pixels: float) -> None:
        """Scroll by `pixels`, at most to the first or last card."""
        self.scroll = min(max(self.scroll + pixels, 0.0), max(0.0, self._full - self.size[1]))

    def _bar(self) -> tuple[pygame.Rect, pygame.Rect] | None:
        """Return the track and the knob of the scroll bar, or None if all cards are visible."""
        top, unit = round(HEADER * self.unit), self.unit
        if self._full <= self.size[1]:
            return None
        track = pygame.Rect(self.size[0] - round((BAR + 6) * unit), top, round(BAR * unit), self.size[1] - top - 6)
        share = (self.size[1] - top) / (self._full - top)
        knob = pygame.Rect(track.left, 0, track.width, max(round(24 * unit), math.ceil(share * track.height)))
        room = track.height - knob.height
        knob.top = track.top + round(room * self.scroll / (self._full - self.size[1]))
        return track, knob

    def handle(self, event: pygame.Event) -> bool:
        """Handle events of the scroll bar. The knob can be dragged. A press on the track moves the knob to the pointer."""
        bar = self._bar()
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1 and bar is not None:
            track, knob = bar
            self.dragged = track.inflate(8, 0).collidepoint(event.pos)
            self._grip = event.pos[1] - knob.top if knob.collidepoint(event.pos) else knob.height / 2
        elif event.type == pygame.MOUSEBUTTONUP and self.dragged:
            self.dragged = False
            return True
        if self.dragged and bar is not None and event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEMOTION):
            track, knob = bar
            share = (event.pos[1] - self._grip - track.top) / max(1, track.height - knob.height)
            self.scroll_by(share * (self._full - self.size[1]) - self.scroll)
            return True
        return False

    def paint_bar(self, surface: pygame.Surface) -> None:
        """Draw the scroll bar."""
        bar = self._bar()
        if bar is not None:
            track, knob = bar
            pygame.draw.rect(surface, tones.grid, track, border_radius=5)
            pygame.draw.rect(surface, tones.muted if self.dragged else tones.faint, knob, border_radius=5)


HOVERED_OPACITY = 24  # Opacity of the tint of the card under the pointer, from 0 to 255.
PRESSED_OPACITY = 48  # Opacity of the tint of a card while the mouse button is down, from 0 to 255.


def _beginning(text: str, ends: Sequence[str], size: float, room: float, most: int) -> list[str]:
    """Return the beginning of `text` that fits into `most` lines and ends with a complete part, split into lines.

    The first string in `ends` contains the characters that end a part. If the first part is too long, the characters of
    the next string in `ends` divide it.
    """
    parts = re.findall(rf".+?(?:[{ends[0]}](?= )|$)", text) or [""]
    wholes = ("".join(parts[: k + 1]).strip(" ;:,") for k in range(len(parts) - 1, -1, -1))
    lines = next((found for whole in wholes if len(found := wrapped(whole, size, room)) <= most), [])
    if lines:
        return lines
    if ends[1:]:
        return _beginning(parts[0], ends[1:], size, room, most)
    lines = wrapped(parts[0], size, room)[:most]
    return [*lines[:-1], shortened(f"{lines[-1]} …", size, room)]


def paint_caption(surface: pygame.Surface, caption: tuple[str, str, str], picture: pygame.Rect, unit: float) -> None:
    """Draw the caption of a scene in four lines below its `picture`.

    The caption consists of the title, complete sentences of the text, and the beginning of the source.
    """
    (title, text, source), room = caption, picture.width - 20 * unit
    x, y = picture.left + 10 * unit, picture.bottom + 7 * unit
    first, *rest = wrapped(title, 16 * unit, room, bold=True)
    titles = [first, " ".join(rest)] if rest else [first]
    for line in titles:
        write(surface, shortened(line, 16 * unit, room, bold=True), (x, y), 16 * unit, tones.foreground, bold=True)
        y += 19 * unit
    lines = _beginning(text, (".?!",), 13 * unit, room, 3 - len(titles))
    for line in lines + _beginning(source, (";", ":,"), 13 * unit, room, 1):
        write(surface, line, (x, y + 2 * unit), 13 * unit, tones.muted)
        y += 17 * unit


def paint_border(surface: pygame.Surface, place: pygame.Rect, hovered: bool, pressed: bool) -> None:
    """Draw the border of a card, and a tint if the pointer is on the card.

    Cards are not pygame_gui buttons. Buttons for all cards would need 100 MB and a third of a second.
    """
    if hovered:
        tint = pygame.Surface(place.size, pygame.SRCALPHA, 32)
        tint.fill((*tones.accent, PRESSED_OPACITY if pressed else HOVERED_OPACITY))
        surface.blit(tint, place)
    pygame.draw.rect(surface, tones.accent if hovered else tones.faint, place, 1)


def _written(paths: Sequence[str]) -> list[tuple[str, int]]:
    """Return each path with the modification time of its file [ns since 1970], or 0 if the file does not exist."""
    return [(path, os.stat(path).st_mtime_ns if os.path.exists(path) else 0) for path in paths]


SCROLL = 60.0  # Scroll distance per notch of the wheel, in design pixels.
SEARCH = 220.0  # Width of the search field in design pixels.


class GalleryPage(Page):
    """The page with all scenes of the catalogue. A click on a card calls `choose(name)`.

    Attributes:
        names: names of the visible scenes in the order of their cards.
        selected: index of the card that Enter opens.
        grid: layout of the cards.
    """

    def __init__(self, host: Host, choose: Callable[[str], None]) -> None:
        self.host, self.choose = host, choose
        self.scenes = {name: load(name) for name in names()}
        self.mine: list[str] = []
        self.recent: list[tuple[str, int]] = []  # Paths of recent files, with their modification times.
        self.captions: dict[str, tuple[str, str, str]] = {}
        self._take_language()
        self.pictures: dict[str, pygame.Surface] = {}
        self.made_for = "", ""  # Theme and language of the present pictures.
        self.english: list[str] = []  # Scenes whose English pictures still have to be redrawn.
        self.drawing: str | None = None  # The scene that is being redrawn.
        self.scaled: dict[tuple[str, tuple[int, int]], pygame.Surface] = {}
        self.selected, self.search = 0, ""
        self.pressed: int | None = None
        self.entry: TextEntry | None = None
        self.grid = CardGrid()
        self.names: tuple[str, ...] = tuple(self.captions)
        self.actions: dict[str, Callable[[], None]] = {
            "select_left": partial(self.step, -1),
            "select_right": partial(self.step, 1),
            "zoom_in": partial(self.step_row, -1),
            "zoom_out": partial(self.step_row, 1),
            "next_control": partial(self.step, 1),
            "previous_control": partial(self.step, -1),
            "first": partial(self.select, 0),
            "last": lambda: self.select(len(self.names) - 1),
            "search": self.focus_search,
            "leave": self.leave,
        }

    def _take_mine(self) -> None:
        """Load the recently opened or saved scene files again."""
        for path in self.mine:
            del self.scenes[path]
        self.mine, self.recent = [], _written(self.host.settings.recent)
        for path, _time in self.recent:
            # A file that was removed, or that is not a scene file, gets no card.
            with contextlib.suppress(SceneError, ValueError, OSError):
                if path.lower().endswith(".toml"):
                    self.scenes[path] = load(path)
                    self.mine.append(path)

    def _take_language(self) -> None:
        """Set the captions in the present language."""
        own = {name: (scene.title, scene.text, scene.source) for name, scene in self.scenes.items()}
        self.captions = {
            name: (scene_words(title), scene_words(text), scene_words(source))
            for name, (title, text, source) in own.items()
        }

    def _take_pictures(self) -> None:
        """Load the thumbnails for the present theme and language.

        A thumbnail with English numbers is shown until its translated version is drawn.
        """
        self.made_for = theme, code = self.host.settings.theme, language()
        self.pictures, self.english = {}, []
        for name, scene in self.scenes.items():
            shipped = thumbnails.shipped(name, theme)
            picture = shipped if shipped is not None and code == ENGLISH else thumbnails.load(scene, theme)
            if picture is None and shipped is not None:
                self.english.append(name)
                picture = shipped
            if picture is None:
                self._draw(name)
            else:
                self.pictures[name] = picture

    def _draw(self, name: str) -> None:
        """Draw the thumbnail of a scene after the background thread has computed its motion."""
        scene = self.scenes[name]
        self.host.warmup.submit(partial(self._take_thumbnail, name, scene), partial(motions_ahead, scene))

    def update(self, seconds: float) -> None:
        """Redraw thumbnails with English numbers in the present language. One is drawn at a time, while the background
        thread is idle.
        """
        if self.english and self.drawing is None and self.host.warmup.complete.is_set():
            self.drawing = self.english.pop(0)
            self._draw(self.drawing)

    @property
    def typing(self) -> bool:  # type: ignore[override]
        """True if the search field receives the keys."""
        return self.entry is not None and self.entry.is_focused

    def cancel_typing(self) -> None:
        """Clear the search and show all scenes."""
        self.host.manager.set_focus_set(None)
        if self.entry is not None:
            self.entry.set_text("")
        self._search("")

    def leave(self) -> None:
        """Clear the search and show all scenes. If there is no search, show how to quit."""
        if self.search:
            self.cancel_typing()
        else:
            self.host.messages.hint(_("Ctrl+Q quits"))

    def focus_search(self) -> None:
        """Give the focus to the search field and select its text, so that typing replaces it."""
        if self.entry is not None:
            self.host.manager.set_focus_set({self.entry})
            self.entry.select_range = [0, len(self.entry.get_text())]

    def let_go(self) -> None:
        """Release the scroll bar."""
        self.grid.dragged = False

    def build(self) -> None:
        """Create the search field and place the cards for the size and unit of the host."""
        unit, width = self.host.unit, self.host.size[0]
        left = width - round((MARGIN + SEARCH) * unit)
        place = pygame.Rect(left, round(18 * unit), round(SEARCH * unit), round(30 * unit))
        text = _("search (Ctrl+F)")
        self.entry = TextEntry(place, self.host.manager, initial_text=self.search, placeholder_text=text)
        self.scaled.clear()
        if self.recent != _written(self.host.settings.recent):
            self._take_mine()
            self.made_for = "", ""  # Mark the pictures as outdated, so that those of changed files are made again.
        self._take_language()
        if self.made_for != (self.host.settings.theme, language()):
            self._take_pictures()
        self._arrange()

    def _arrange(self) -> None:
        sections = sections_of(list(self.captions), self.mine)
        # A search keeps the order of the gallery among scenes of the same rank.
        ordered = {name: self.captions[name] for section in sections for name in section.names}
        names = found(ordered, self.search)
        if self.search:
            sections = [Section(FOUND, tuple(names))] if names else []
        self.names = tuple(name for section in sections for name in section.names)
        self.selected = min(self.selected, max(0, len(self.names) - 1))
        self.grid.arrange(self.host.size, self.host.unit, sections)

    def _search(self, text: str) -> None:
        if text != self.search:
            self.search, self.selected, self.grid.scroll = text, 0, 0.0
            self._arrange()

    def select(self, k: int) -> None:
        """Select card `k` and scroll to it."""
        if self.names:
            self.selected = min(max(k, 0), len(self.names) - 1)
            self.grid.show(self.selected)

    def step(self, by: int) -> None:
        """Move the selection by `by` cards."""
        self.select(self.selected + by)

    def step_row(self, by: int) -> None:
        """Move the selection to the nearest card in the next row below (1) or above (-1)."""
        if self.names:
            self.select(self.grid.neighbour(self.selected, by))

    def handle(self, event: pygame.Event) -> bool:
        """Handle the search field, the scroll bar, clicks, the wheel, and keys that move the selection or open a scene."""
        return self._typed(event) or self.grid.handle(event) or self._clicked(event) or self._key(event)

    def _typed(self, event: pygame.Event) -> bool:
        """Handle events of the search field."""
        if event.type == pygame_gui.UI_TEXT_ENTRY_CHANGED and event.ui_element is self.entry:
            self._search(event.text)
            return True
        if event.type == pygame_gui.UI_TEXT_ENTRY_FINISHED and event.ui_element is self.entry:
            self.host.manager.set_focus_set(None)
            if self.names:
                self.choose(self.names[self.selected])
            return True
        return False

    def _clicked(self, event: pygame.Event) -> bool:
        """Handle clicks on cards and the wheel."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.pressed = self.grid.card_at(event.pos)
            return self.pressed is not None
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self.pressed is not None:
            pressed, self.pressed = self.pressed, None
            if self.grid.card_at(event.pos) == pressed:
                self.choose(self.names[pressed])
            return True
        if event.type == pygame.MOUSEWHEEL:
            self.grid.scroll_by(-event.precise_y * SCROLL * self.host.unit)
            return True
        return False

    def _key(self, event: pygame.Event) -> bool:
        """Handle keys that move the selection or open a scene."""
        if event.type != pygame.KEYDOWN or self.typing:
            return False
        if event.key in (pygame.K_RETURN, pygame.K_KP_ENTER) and self.names:
            self.choose(self.names[self.selected])
        elif event.key in (pygame.K_PAGEUP, pygame.K_PAGEDOWN):
            for _ in range(2):
                self.step_row(-1 if event.key == pygame.K_PAGEUP else 1)
        else:
            return False
        return True

    def _take_thumbnail(self, name: str, scene: Scene, motions: object) -> None:
        """Draw the thumbnail of a scene from its computed motion. If the computation failed, draw the start of the
        scene.
        """
        if self.drawing == name:
            self.drawing = None
        if self.scenes.get(name) is not scene:
            return
        self.scaled.clear()
        if isinstance(motions, list):
            self.pictures[name] = thumbnails.paint(scene, motions)
            thumbnails.save(scene, self.host.settings.theme, self.pictures[name])
        else:
            self.pictures[name] = thumbnails.paint(scene, thumbnails.start_of(scene))

    @property
    def moving(self) -> bool:  # type: ignore[override]
        """True while thumbnails are missing."""
        return len(self.pictures) < len(self.captions)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the cards in their sections, and the header above them."""
        unit, (width, height) = self.host.unit, self.host.size
        surface.fill(tones.background)
        for title, y in self.grid.titles():
            write(surface, title, (MARGIN * unit, y), 16 * unit, tones.foreground, bold=True)
        for k in range(len(self.names)):
            place = self.grid.place(k)
            if place.bottom > HEADER * unit and place.top < height:
                self._card(surface, k, place)
        surface.fill(tones.background, (0, 0, width, round((HEADER - 4) * unit)))
        x, y = MARGIN * unit, 16 * unit
        write(surface, "softcradle", (x, y), 22 * unit, tones.foreground, bold=True)
        line = _("A row of soft beads: push the first and see who moves. Choose a scene, or drop a scene file here.")
        room = width - 2 * x - 80 * unit
        write(surface, shortened(line, 16 * unit, room), (x, y + 38 * unit), 16 * unit, tones.muted)
        write(surface, _("F1: help"), (width - x, y + 38 * unit), 16 * unit, tones.muted, align=(1, 0))
        if not self.names:
            text = _("No scene has {text!r} in its title, text or source. Esc shows all.", text=self.search)
            write(surface, text, (x, (HEADER + 20) * unit), 16 * unit, tones.muted)
        self.grid.paint_bar(surface)

    def _card(self, surface: pygame.Surface, k: int, place: pygame.Rect) -> None:
        unit, name = self.host.unit, self.names[k]
        image = self._image(name)
        picture = pygame.Rect(place.topleft, self.grid.picture_size)
        if image is None:
            surface.fill(tones.lane_background, picture)
            write(surface, _("drawing …"), picture.center, 13 * unit, tones.muted, align=(0.5, 0.5))
        else:
            surface.blit(image, picture)
        paint_caption(surface, self.captions[name], picture, unit)
        surface.fill(tones.faint, (place.left, picture.bottom, place.width, 1))
        hovered = self.grid.card_at(pygame.mouse.get_pos()) == k
        paint_border(surface, place, hovered, hovered and self.pressed == k)
        if k == self.selected:
            frame = place.inflate(round(4 * unit), round(4 * unit))
            pygame.draw.rect(surface, tones.foreground, frame, max(2, round(2 * unit)))

    def _image(self, name: str) -> pygame.Surface | None:
        """Return the picture of a scene at its present size, or None."""
        if name not in self.pictures:
            return None
        key = (name, self.grid.picture_size)
        if key not in self.scaled:
            self.scaled[key] = pygame.transform.smoothscale(self.pictures[name].convert(), self.grid.picture_size)
        return self.scaled[key]

    def close(self) -> None:
        """Discard the scaled pictures but keep the scroll position."""
        self.scaled.clear()
        self.pressed = None
