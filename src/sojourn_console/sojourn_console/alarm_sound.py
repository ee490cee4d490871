"""What an alarm sounds like: short tones, as a sound that a browser plays."""

import base64
import io
import wave
from functools import cache

import numpy as np

from sojourn_operator.alarms.params import Severity

RATE = 8000
"""Samples a second."""
TONES = {Severity.WARNING: (660.0, 1), Severity.CRITICAL: (880.0, 3)}
"""Pitch [Hz], and how often."""
TONE_S, PAUSE_S, EDGE_S = 0.18, 0.09, 0.01
LOUDNESS = 0.35


@cache
def sound_of(severity: Severity) -> bytes:
    """A WAV file, 16 bits, one channel; empty for what is not heard."""
    if severity not in TONES:
        return b""
    pitch, times = TONES[severity]
    t = np.arange(round(TONE_S * RATE)) / RATE
    edges = np.clip(np.minimum(t, TONE_S - t) / EDGE_S, 0.0, 1.0)  # a tone that begins at once clicks
    tone = LOUDNESS * edges * np.sin(2.0 * np.pi * pitch * t)
    samples = np.tile(np.concatenate([tone, np.zeros(round(PAUSE_S * RATE))]), times)
    file = io.BytesIO()
    with wave.open(file, "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(RATE)
        sound.writeframes((32767 * samples).astype("<i2").tobytes())
    return file.getvalue()


def sound_html(severity: Severity, number: int) -> str:
    """An element that plays it as soon as it is there; each number is heard once."""
    data = base64.b64encode(sound_of(severity)).decode()
    return f'<audio autoplay data-alarm="{number}" src="data:audio/wav;base64,{data}"></audio>' if data else ""
