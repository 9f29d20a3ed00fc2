"""Languages of the window. The code contains the English texts. Each other language has a catalogue of translations,
LC_MESSAGES/softcradle.po.
"""

from softcradle.sandbox.languages.translation import ENGLISH as ENGLISH
from softcradle.sandbox.languages.translation import LANGUAGES as LANGUAGES
from softcradle.sandbox.languages.translation import N_ as N_
from softcradle.sandbox.languages.translation import NP_ as NP_
from softcradle.sandbox.languages.translation import VARIABLES as VARIABLES
from softcradle.sandbox.languages.translation import Language as Language
from softcradle.sandbox.languages.translation import _ as _
from softcradle.sandbox.languages.translation import english as english
from softcradle.sandbox.languages.translation import error_words as error_words
from softcradle.sandbox.languages.translation import gettext as gettext
from softcradle.sandbox.languages.translation import in_every_language as in_every_language
from softcradle.sandbox.languages.translation import language as language
from softcradle.sandbox.languages.translation import language_of_environment as language_of_environment
from softcradle.sandbox.languages.translation import localized as localized
from softcradle.sandbox.languages.translation import message_words as message_words
from softcradle.sandbox.languages.translation import ngettext as ngettext
from softcradle.sandbox.languages.translation import pgettext as pgettext
from softcradle.sandbox.languages.translation import scene_words as scene_words
from softcradle.sandbox.languages.translation import use_language as use_language
