// Constants that sandbox/story/page_story.py puts before the scripts of a page.
declare const STORY: Record<
  "together" | "resolution" | "slow" | "momentum" | "energy" | "stands" | "equal" | "atRest" | "groups" | "digits" |
  "frameRate" | "stepCost" | "frameCost" | "contactSteps" | "handFrequency" | "handSpeed", number
>;
declare const WORDS: Record<string, Record<string, string>>;
