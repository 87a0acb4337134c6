// tests/io/expect_error.h -- an action must throw an Error of this kind whose text has these words.
#pragma once
#include "engine/error.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

namespace sigmaflow::testing_io {

template <class Action>
void expect_error(ErrorKind kind, std::initializer_list<std::string> words, const Action& action)
{
    try {
        action();
        ADD_FAILURE() << "no error was thrown";
    } catch (const Error& error) {
        const std::string text = error.what();
        EXPECT_EQ(error.kind(), kind) << text;
        for (const std::string& word : words)
            EXPECT_NE(text.find(word), std::string::npos) << "no \"" << word << "\" in: " << text;
    }
}

}
